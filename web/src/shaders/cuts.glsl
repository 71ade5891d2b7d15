// Flat cuts, which have the normals of their planes, as in the core (core/src/field/field.cpp). The
// values have dents there.

#ifdef CUTS
uniform vec4 slabs[3 * CUTS];  // unit normal and offset in index coordinates, three for each cut
uniform float halfWidths[3 * CUTS];
uniform float keeps[CUTS];  // 1: keeps the inside of its slabs; -1: the outside
uniform vec2 cutRange;      // codes of the ramp of values at a cut, and a voxel inside

const float ROUNDING = 0.005;  // of values, in voxels

// Returns the direction into the data at the nearest cut, and the distance from it in voxels.
vec4 wayIntoData(vec3 place) {
  vec4 nearest = vec4(vec3(0.0), FAR_AWAY);
  for (int cut = 0; cut < CUTS; ++cut) {
    vec4 own = nearest;
    own.w = FAR_AWAY;
    for (int k = 3 * cut; k < 3 * cut + 3; ++k) {
      float along = dot(slabs[k], vec4(place, 1.0)), depth = halfWidths[k] - abs(along);
      if (depth < own.w) own = vec4(along < 0.0 ? slabs[k].xyz : -slabs[k].xyz, depth);
    }
    own *= keeps[cut];
    if (own.w < nearest.w) nearest = own;
  }
  return nearest;
}

// Returns the gradient of the nearest cut, and its share in that of the isosurface. The share is 1 if
// all voxels around are inside or lowered by cuts, and fades across the edge of a face.
vec4 gradientOnCut(vec3 place, float isovalue) {
  vec4 way = wayIntoData(place);
  float steepness = cutRange.y - cutRange.x;
  // A ramp is a voxel wide.
  if (abs(way.w) > 2.0) return vec4(0.0);
  ivec3 cell = min(ivec3(place), dims - 2);
  vec3 u = place - vec3(cell);
  vec4 low = quadAt(cell), high = quadAt(cell + ivec3(0, 0, 1));
  float lowered = 0.0, outside = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    ivec3 offset = ivec3(corner, corner >> 1, corner >> 2) & 1;
    vec3 share = mix(1.0 - u, u, vec3(offset));
    float weight = share.x * share.y * share.z;
    float value = offset.z == 0 ? low[corner & 3] : high[corner & 3];
    float ramp = cutRange.x + steepness * (wayIntoData(vec3(cell + offset)).w - ROUNDING);
    if (value >= ramp) {
      lowered += weight;
    } else if (value < isovalue) {
      outside += weight;
    }
  }
  return lowered == 0.0 ? vec4(0.0) : vec4(way.xyz * steepness, lowered / (lowered + outside));
}
#endif
