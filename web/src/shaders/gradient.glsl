// Gradients of the values, in index coordinates (core/src/field/field.cpp).

uniform mat4 indexToWorld;
uniform mat3 normalToWorld;  // index to world, for gradients

#ifdef SMOOTH_NORMALS
uniform usampler3D smoothValues;  // smoothed values, in the layout of `values`
uniform float smoothPerCode;      // codes of `smoothValues` per code of `values`

float shadingValueAt(vec3 place) { return valueOf(smoothValues, place) / smoothPerCode; }
#else
float shadingValueAt(vec3 place) { return valueAt(place); }
#endif

// Returns interpolated central differences, or on a flat cut the gradient of its plane. Differences
// are one-sided at the border and beside missing values.
vec3 gradientAt(vec3 place, float isovalue) {
#ifdef CUTS
  vec4 onCut = gradientOnCut(place, isovalue);
  if (onCut.w == 1.0) return onCut.xyz;
#endif
#ifdef SMOOTH_NORMALS
  float own = noData >= 0.0 ? shadingValueAt(place) : isovalue;
#else
  float own = isovalue;
#endif
  vec3 g;
  for (int a = 0; a < 3; ++a) {
    vec3 low = place, high = place;
    float last = float(dims[a] - 1), voxel = min(floor(place[a]), last - 1.0);
    if (voxel > 0.0 && voxel + 1.0 < last) {
      low[a] -= 1.0;
      high[a] += 1.0;
      float below = shadingValueAt(low), above = shadingValueAt(high);
      if (below < 0.0) below = own, low = place;
      if (above < 0.0) above = own, high = place;
      float way = high[a] - low[a];
      g[a] = way > 0.0 ? (above - below) / way : 0.0;
    } else {
      low[a] = voxel;
      high[a] = voxel + 1.0;
      float below = shadingValueAt(low), above = shadingValueAt(high);
      float first = above - below, second = first;
      low[a] = voxel - 1.0;
      high[a] = voxel + 2.0;
      if (low[a] >= 0.0) {
        float before = shadingValueAt(low);
        if (before >= 0.0) first = 0.5 * (above - before);
      }
      if (high[a] <= last) {
        float behind = shadingValueAt(high);
        if (behind >= 0.0) second = 0.5 * (behind - below);
      }
      g[a] = mix(first, second, place[a] - voxel);
    }
  }
#ifdef CUTS
  g = mix(g, onCut.xyz, onCut.w);
#endif
  return g;
}

#ifdef SMOOTH_NORMALS
// A zero gradient would be dark, so use the derivative in the cell.
vec3 surfaceGradient(vec3 place, vec3 shading) { return shading; }
#else
// Returns the derivative of the values in their cell. It jumps at faces of cells; near them it is
// blended with the shading gradient.
vec3 surfaceGradient(vec3 place, vec3 shading) {
  ivec3 cell = min(ivec3(place), dims - 2);
  vec3 u = place - vec3(cell);
  vec4 low = quadAt(cell), high = quadAt(cell + ivec3(0, 0, 1)), q = mix(low, high, u.z);
  vec4 along = high - low;
  vec3 own = vec3(mix(q.y - q.x, q.w - q.z, u.y), mix(q.z - q.x, q.w - q.y, u.x),
                  mix(mix(along.x, along.y, u.x), mix(along.z, along.w, u.x), u.y));
  return mix(shading, own, min(min(u, 1.0 - u) / 0.05, 1.0));
}
#endif
