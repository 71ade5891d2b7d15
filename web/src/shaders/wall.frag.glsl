// Draws a wall, except between the viewer and the volumes (python/leaflight/stills/walls.py).

uniform bool isOfRoom, isLocal;
uniform vec3 middle, albedo, emission;

in vec3 place, fromFront, fromBack;
out vec4 color;

void main() {
  vec3 normal = cross(dFdx(place), dFdy(place));
  float side = dot(normal, worldEye - place);
  if (isOfRoom && side * dot(normal, middle - place) < 0.0) discard;
  vec3 radiance = gl_FrontFacing ? fromFront : fromBack;
  if (isLocal) {
    normal = normalize(side < 0.0 ? -normal : normal);
    radiance = exposure * (albedo * irradianceOverPi(place, normal) + emission);
  }
  color = vec4(displayed(radiance), 1.0);
}
