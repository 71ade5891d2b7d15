// The view transform: exposed, clamped, encoded as sRGB, as leaflight still and the add-on show it.
uniform float gain;

vec3 displayed(vec3 exposed) {
  vec3 linear = clamp(exposed * gain, 0.0, 1.0);
  vec3 curve = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
  return mix(curve, 12.92 * linear, vec3(lessThanEqual(linear, vec3(0.0031308))));
}
