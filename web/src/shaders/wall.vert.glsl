in vec3 position, frontLight, backLight;  // world; times the exposure of the scene
uniform mat4 worldToClip;
uniform vec3 centre;  // of the mesh
out vec3 place, fromFront, fromBack;

void main() {
  place = position;
  fromFront = frontLight;
  fromBack = backLight;
  // Walls whose edges meet differ in their vertices by rounding. Each reaches over the edge by less
  // than a pixel, so that none lets the background through.
  vec3 grown = centre + 1.0003 * (position - centre);
  gl_Position = worldToClip * vec4(grown, 1.0);
}
