in vec3 position, frontLight, backLight;  // world position; light times the exposure of the scene
uniform mat4 worldToClip;
uniform vec3 center;  // center of the mesh
out vec3 place, fromFront, fromBack;

void main() {
  place = position;
  fromFront = frontLight;
  fromBack = backLight;
  // Adjacent walls have vertices that differ by rounding. Extend each wall by less than a pixel, so
  // that the background is not visible between them.
  vec3 grown = center + 1.0003 * (position - center);
  gl_Position = worldToClip * vec4(grown, 1.0);
}
