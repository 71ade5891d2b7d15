// The view transform: exposure, compression of highlights, sRGB
// (python/leaflight/stills/photograph.py).
uniform float gain;

// Khronos PBR Neutral without its offset for specular reflection.
vec3 toneMapped(vec3 linear) {
  const float START = 0.8, REST = 0.2, DESATURATION = 0.15;
  float peak = max(linear.r, max(linear.g, linear.b));
  if (peak <= START) return linear;
  float shown = 1.0 - REST * REST / (peak + REST - START);
  float white = 1.0 - 1.0 / (DESATURATION * (peak - shown) + 1.0);
  return mix(linear * (shown / peak), vec3(shown), white);
}

vec3 displayed(vec3 exposed) {
  vec3 linear = toneMapped(max(exposed * gain, 0.0));
  vec3 curve = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
  return mix(curve, 12.92 * linear, vec3(lessThanEqual(linear, vec3(0.0031308))));
}
