// The light of a point on a leaf: of the bake, or by lamps alone (core/leaflight/still/lamps.py).

uniform sampler3D outer, inner;  // bricks of radiance times the exposure of the scene
uniform usampler3D table;        // where in these each brick is
uniform ivec3 brick, bricks;     // texels of a brick, with the layers that it shares; their numbers
uniform vec3 texelScale, textureScale;  // from index coordinates to texels; one over the textures'
uniform int innerIs;                    // 0: baked, 1: dark, 2: to be shaded locally
uniform bool isLocal;
uniform mat4 indexToWorld;
uniform mat3 normalToWorld;  // of gradients
uniform vec3 worldEye, ambient, albedo, emission;
uniform int lampCount;  // -1: a headlight
uniform vec4 lamps[48];
uniform float exposure;  // of the scene

vec3 irradianceOverPi(vec3 place, vec3 normal) {
  if (lampCount < 0) return vec3(max(dot(normal, normalize(worldEye - place)), 0.0));
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
  return total / 3.14159265358979 + ambient;
}

// Central differences between voxels, interpolated; one-sided where one of the two is missing.
vec3 gradientAt(vec3 place, float own) {
  vec3 g;
  for (int a = 0; a < 3; ++a) {
    vec3 low = place, high = place;
    low[a] = max(low[a] - 1.0, 0.0);
    high[a] = min(high[a] + 1.0, float(dims[a] - 1));
    float below = valueAt(low), above = valueAt(high);
    if (below < 0.0) below = own, low = place;
    if (above < 0.0) above = own, high = place;
    float way = high[a] - low[a];
    g[a] = way > 0.0 ? (above - below) / way : 0.0;
  }
  return g;
}

vec3 light(vec3 place, Hit hit, float isovalue) {
  if (!isLocal && !(hit.fromInside && innerIs != 0)) {
    fetches += 2;
    vec3 texel = max(place * texelScale, 0.0);
    ivec3 within = min(ivec3(texel) / (brick - 1), bricks - 1);
    vec3 first = vec3(texelFetch(table, within, 0).xyz) * vec3(brick);
    vec3 at = (first + texel - vec3(within * (brick - 1)) + 0.5) * textureScale;
    return hit.fromInside ? texture(inner, at).rgb : texture(outer, at).rgb;
  }
  if (!isLocal && innerIs == 1) return vec3(0.0);
  vec3 normal = -normalize(normalToWorld * gradientAt(place, isovalue));
  if (hit.fromInside) normal = -normal;
  vec3 world = (indexToWorld * vec4(place, 1.0)).xyz;
  return exposure * (albedo * irradianceOverPi(world, normal) + emission);
}
