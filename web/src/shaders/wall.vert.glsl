in vec3 position, outerLight, innerLight;  // world; times the exposure of the scene
uniform mat4 worldToClip;
out vec3 place, fromOuter, fromInner;

void main() {
  place = position;
  fromOuter = outerLight;
  fromInner = innerLight;
  gl_Position = worldToClip * vec4(position, 1.0);
}
