// Local shading: light of lamps on a surface, without shadows (python/leaflight/stills/lamps.py).

uniform vec3 worldEye, ambient;
uniform int lampCount;  // -1: a headlight
uniform vec4 lamps[48];
uniform float exposure;  // exposure of the scene

const float PI = 3.14159265358979;

float headlight(vec3 place, vec3 normal) {
  return max(dot(normal, normalize(worldEye - place)), 0.0);
}

vec3 irradianceOverPi(vec3 place, vec3 normal) {
  if (lampCount < 0) return vec3(headlight(place, normal));
  vec3 total = vec3(0.0);
  for (int k = 0; k < lampCount; ++k) {
    vec4 position = lamps[3 * k], axis = lamps[3 * k + 1], intensity = lamps[3 * k + 2];
    int kind = int(position.w);
    vec3 way = position.xyz - (kind == 0 ? vec3(0.0) : place);
    float squared = max(dot(way, way), 1e-30);
    way *= inversesqrt(squared);
    float share = max(dot(way, normal), 0.0);
    if (kind != 0) {
      float cosine = -dot(way, axis.xyz);
      share /= squared;
      if (kind == 1) {
        share *= clamp((cosine - axis.w) / max(intensity.w - axis.w, 1e-6), 0.0, 1.0);
      } else {
        share *= max(kind == 3 ? abs(cosine) : cosine, 0.0);
      }
    }
    total += share * intensity.xyz;
  }
  return total / PI + ambient;
}
