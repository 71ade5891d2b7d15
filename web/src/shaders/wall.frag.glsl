// A lit wall, left out where it stands between the viewer and the volumes
// (core/leaflight/still/walls.py).

uniform bool isOfRoom;
uniform vec3 worldEye, middle;

in vec3 place, fromOuter, fromInner;
out vec4 color;

void main() {
  vec3 normal = cross(dFdx(place), dFdy(place));
  if (isOfRoom && dot(normal, worldEye - place) * dot(normal, middle - place) < 0.0) discard;
  color = vec4(displayed(gl_FrontFacing ? fromOuter : fromInner), 1.0);
}
