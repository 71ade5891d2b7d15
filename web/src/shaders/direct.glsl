// Direct light at a point of an isosurface (core/src/bake/direct/direct_light.cpp).

uniform usampler3D maps;       // levels of eight light points a texel, in bricks, stacked along z
uniform usampler3D mapTable;   // position of each brick
uniform usampler3D mapRanges;  // least and greatest visibility code around each texel
uniform sampler2D lightPoints;  // four texels each, as in DirectLight.light_points
uniform ivec3 mapTexels, mapBrick, mapBricks;
uniform int mapDepth;  // texels of a layer along z
uniform vec2 codeRange;  // codes of the volume at visibility codes 1 and 253
uniform mat4 indexToFrame;

struct DirectLight {
  vec3 irradiance, reflected;  // reflected by the coat
};

// Offsets of the parts of a range, one for each light point
// (python/leaflight/export/visibility_levels.py).
const float PARTS = 12.0, SHIFT = 0.6180339887;
const uint DARK = 15u;

// Returns the unshadowed light of a light point at a surface.
DirectLight unshadowed(int point, vec3 place, vec3 normal, vec3 geometricNormal, Coat coat) {
  DirectLight none = DirectLight(vec3(0.0), vec3(0.0));
  ++fetches;
  vec4 at = texelFetch(lightPoints, ivec2(0, point), 0);
  vec3 way = at.w * place - at.xyz;
  float perDistance = inversesqrt(dot(way, way));
  way *= perDistance;
  float cosine = -dot(way, normal);
  if (cosine <= 0.0 || dot(way, geometricNormal) >= 0.0) return none;
  fetches += 3;
  vec4 axis = texelFetch(lightPoints, ivec2(1, point), 0);
  float leaving = dot(way, axis.xyz);
  float share = axis.w == 0.0 ? 1.0 : axis.w == 1.0 ? max(leaving, 0.0) : abs(leaving);
  vec4 amount = texelFetch(lightPoints, ivec2(2, point), 0);
  vec4 cone = texelFetch(lightPoints, ivec2(3, point), 0);
  float inside = max(dot(way, cone.xyz) - cone.w, 0.0);
  share *= inside < amount.w ? smoothstep(0.0, 1.0, inside / amount.w) : float(inside > 0.0);
  vec3 irradiance = amount.rgb * (share * cosine * perDistance * perDistance);
  return DirectLight(irradiance, coat.weight == 0.0 ? vec3(0.0) : irradiance * reflectance(coat, normal, -way));
}

// Returns direct light of an isosurface at index coordinates.
DirectLight directLight(vec3 place, vec3 gradient, float isovalue, bool isBack, vec2 gloss) {
  DirectLight total = DirectLight(vec3(0.0), vec3(0.0));
  vec3 texel = clamp(place * (vec3(mapTexels - 1) / vec3(dims - 1)), vec3(0.0), vec3(mapTexels - 1));
  ivec3 cell = min(ivec3(texel), mapTexels - 2);
  vec3 u = texel - vec3(cell);
  ivec3 within = min(cell / (mapBrick - 1), mapBricks - 1);
  uvec4 entry = texelFetch(mapTable, within, 0);
  ++fetches;
  if (entry.w == 0u) return total;
  ivec3 first = ivec3(entry.xyz) * mapBrick + cell - within * (mapBrick - 1);
  float own = 1.0 + 252.0 * (isovalue - codeRange.x) / (codeRange.y - codeRange.x);
  int pointCount = textureSize(lightPoints, 0).y, groups = (pointCount + 7) / 8;
  if (isBack) own = 254.0 - own, first.z += groups * mapDepth;
  float weight[8];
  vec2 range[8];  // start and length
  for (int corner = 0; corner < 8; ++corner) {
    ivec3 offset = ivec3(corner, corner >> 1, corner >> 2) & 1;
    vec3 share = mix(1.0 - u, u, vec3(offset));
    weight[corner] = share.x * share.y * share.z;
    vec2 codes = vec2(texelFetch(mapRanges, cell + offset, 0).xy);
    range[corner] = vec2(isBack ? 254.0 - codes.y : codes.x, codes.y - codes.x);
  }
  fetches += 8;
  if (gradient == vec3(0.0)) return total;
  float side = isBack ? 1.0 : -1.0;
  vec3 normal = side * normalize(normalToWorld * gradient);
  vec3 geometricNormal = side * normalToWorld * surfaceGradient(place, gradient);
  vec3 framed = (indexToFrame * vec4(place, 1.0)).xyz;
  Coat coat = coatAt((indexToWorld * vec4(place, 1.0)).xyz, normal, gloss);
  for (int group = 0; group < groups; ++group) {
    // Greatest code on the light path, and true if a mesh blocks it, for even and odd points.
    vec4 greatest[2] = vec4[2](vec4(0.0), vec4(0.0)), dark[2] = greatest;
    vec4 evenPoints = 8.0 * float(group) + vec4(0.0, 2.0, 4.0, 6.0);
    vec4 shift[2] = vec4[2](fract(evenPoints * SHIFT), fract((evenPoints + 1.0) * SHIFT));
    for (int corner = 0; corner < 8; ++corner) {
      ivec3 offset = ivec3(corner, corner >> 1, corner >> 2) & 1;
      uvec4 levels = texelFetch(maps, first + offset + ivec3(0, 0, group * mapDepth), 0);
      for (int odd = 0; odd < 2; ++odd) {
        uvec4 level = odd == 0 ? levels & 15u : levels >> 4;
        vec4 isDark = vec4(equal(level, uvec4(DARK))) * weight[corner];
        vec4 part = clamp((vec4(level) - 1.5 + shift[odd]) / PARTS, 0.0, 1.0);
        dark[odd] += isDark;
        greatest[odd] += (weight[corner] - isDark) * (range[corner].x + range[corner].y * part);
      }
    }
    fetches += 8;
    int end = min(8, pointCount - 8 * group);
    for (int k = 0; k < end; ++k) {
      float behindMesh = dark[k & 1][k >> 1];
      if (behindMesh >= 0.5 || greatest[k & 1][k >> 1] >= own * (1.0 - behindMesh)) continue;
      DirectLight one = unshadowed(8 * group + k, framed, normal, geometricNormal, coat);
      total.irradiance += one.irradiance;
      total.reflected += one.reflected;
    }
  }
  return total;
}
