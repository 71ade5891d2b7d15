// The light of a point on a leaf: of the bake, or by lamps alone (core/leaflight/still/lamps.py).

uniform sampler3D outer, inner;  // bricks of radiance times the exposure of the scene
uniform usampler3D table;        // where in these each brick is
uniform ivec3 brick, bricks;     // texels of a brick, with the layers that it shares; their numbers
uniform vec3 texelScale, textureScale;  // from index coordinates to texels; one over the textures'
uniform int innerIs;                    // 0: baked, 1: dark, 2: to be shaded locally
uniform bool isLocal;
uniform mat4 indexToWorld;
uniform vec3 worldEye, ambient;
uniform vec3 albedo[2], emission[2];  // of both isosurfaces
uniform int lampCount;  // -1: a headlight
uniform vec4 lamps[48];
uniform float exposure;  // of the scene

const float PI = 3.14159265358979;

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
  return total / PI + ambient;
}

// Radiance of the texels about a place.
vec3 ofTexels(vec3 place, bool isInner) {
  fetches += 2;
  vec3 texel = max(place * texelScale, 0.0);
  ivec3 within = min(ivec3(texel) / (brick - 1), bricks - 1);
  uvec4 entry = texelFetch(table, within, 0);
  if (entry.w == 0u) return vec3(0.0);
  vec3 first = vec3(entry.xyz) * vec3(brick);
  vec3 at = (first + texel - vec3(within * (brick - 1)) + 0.5) * textureScale;
  return isInner ? texture(inner, at).rgb : texture(outer, at).rgb;
}

// Of the first or the second isosurface.
vec3 light(vec3 place, Hit hit, float isovalue, int number) {
  if (!isLocal && !(hit.fromInside && innerIs != 0)) {
    vec3 radiance = ofTexels(place, hit.fromInside);
#ifdef DIRECT
    vec3 irradiance = directIrradiance(place, isovalue, hit.fromInside);
    radiance += exposure / PI * albedo[number] * irradiance;
#endif
    return radiance;
  }
  if (!isLocal && innerIs == 1) return vec3(0.0);
  vec3 normal = -normalize(normalToWorld * gradientAt(place, isovalue));
  if (hit.fromInside) normal = -normal;
  vec3 world = (indexToWorld * vec4(place, 1.0)).xyz;
  return exposure * (albedo[number] * irradianceOverPi(world, normal) + emission[number]);
}
