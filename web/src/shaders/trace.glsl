// Finds the first hit of a ray on an isosurface of the trilinear field, as the core does
// (core/src/trace/isosurface_ray.cpp, core/src/trace/cell_crossing.h).

uniform usampler3D values;        // codes of voxels (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)
uniform usampler3D bounds;        // least and greatest code of 4^3 cells
uniform usampler3D coarseBounds;  // least and greatest code of 16^3 cells
uniform ivec3 dims;               // voxels
uniform vec2 isovalueRange;  // codes of the isovalues that are lit
uniform float noData;             // code of masked voxels; negative for none

const int NOWHERE = -1, BELOW = 0, ABOVE = 1, UNKNOWN = 2, MIXED = 3;
const float FAR_AWAY = 1e30;

struct Ray {
  vec3 origin, direction;  // index coordinates
  float t, end;            // part of the ray within the box
};
struct Hit {
  float t;          // negative for none
  bool fromInside;  // the ray arrived from higher values
};

int fetches = 0;

vec4 quadOf(usampler3D of, ivec3 voxel) {
  ++fetches;
  return vec4(texelFetch(of, voxel, 0));
}

vec4 quadAt(ivec3 voxel) { return quadOf(values, voxel); }

Ray rayThroughBox(vec3 origin, vec3 direction) {
  Ray ray = Ray(origin, direction, 0.0, FAR_AWAY);
  for (int a = 0; a < 3; ++a) {
    float last = float(dims[a] - 1);
    if (direction[a] == 0.0) {
      if (origin[a] < 0.0 || origin[a] > last) ray.end = -1.0;
      continue;
    }
    float low = -origin[a] / direction[a], high = (last - origin[a]) / direction[a];
    ray.t = max(ray.t, min(low, high));
    ray.end = min(ray.end, max(low, high));
  }
  return ray;
}

float largest(vec4 v) { return max(max(v.x, v.y), max(v.z, v.w)); }

// A negative value means no data.
float valueOf(usampler3D of, vec3 place) {
  vec3 at = clamp(place, vec3(0.0), vec3(dims - 1));
  ivec3 cell = min(ivec3(at), dims - 2);
  vec3 u = at - vec3(cell);
  vec4 low = quadOf(of, cell), high = quadOf(of, cell + ivec3(0, 0, 1));
  if (noData >= 0.0 && largest(max(low, high)) >= noData) return -1.0;
  vec4 q = mix(low, high, u.z);
  return mix(mix(q.x, q.y, u.x), mix(q.z, q.w, u.x), u.y);
}

float valueAt(vec3 place) { return valueOf(values, place); }

// Returns the side of a region without a crossing, UNKNOWN without data, or MIXED.
int sideOf(usampler3D of, ivec3 brick, float isovalue) {
  ++fetches;
  vec2 range = vec2(texelFetch(of, brick, 0).xy);
  if (noData >= 0.0 && range.y >= noData) return range.x >= noData ? UNKNOWN : MIXED;
  if (range.x >= isovalue) return ABOVE;
  return range.y < isovalue ? BELOW : MIXED;
}

// Returns h - c along the segment between two points of a cell: coefficients of s^0 to s^3, s in
// [0,1].
vec4 alongSegment(vec4 low, vec4 high, vec3 from, vec3 way) {
  vec4 e0 = vec4(low.xz, high.xz), e1 = vec4(low.yw, high.yw) - e0;
  vec4 a = e0 + e1 * from.x, b = e1 * way.x;  // edges along x: (y0 z0, y1 z0, y0 z1, y1 z1)
  vec2 d0 = a.yw - a.xz, d1 = b.yw - b.xz;
  vec2 f0 = a.xz + d0 * from.y, f1 = b.xz + d1 * from.y + d0 * way.y, f2 = d1 * way.y;
  float g0 = f0.y - f0.x, g1 = f1.y - f1.x, g2 = f2.y - f2.x;
  return vec4(f0.x + g0 * from.z, f1.x + g1 * from.z + g0 * way.z, f2.x + g2 * from.z + g1 * way.z,
              g2 * way.z);
}

float evaluate(vec4 p, float s) { return p.x + s * (p.y + s * (p.z + s * p.w)); }

// Returns the first s at which the polynomial changes sign; negative for none.
float firstCrossing(vec4 p, bool above) {
  bool b1 = p.x + p.y / 3.0 >= 0.0, b2 = p.x + (2.0 * p.y + p.z) / 3.0 >= 0.0;
  bool b3 = p.x + p.y + p.z + p.w >= 0.0;
  // Without a change of sign among the Bernstein coefficients there is no root.
  if (b1 == above && b2 == above && b3 == above) return -1.0;
  float low = 0.0, high = 1.0;
  if (int(b1 != above) + int(b2 != b1) + int(b3 != b2) != 1) {
    // Search between the roots of the derivative.
    float a = p.y, b = 2.0 * p.z, c = 3.0 * p.w, discriminant = b * b - 4.0 * a * c;
    bool found = false;
    if (discriminant >= 0.0) {
      float q = -0.5 * (b + (b < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
      float r0 = q != 0.0 ? a / q : -1.0, r1 = c != 0.0 ? q / c : -1.0;
      for (int k = 0; k < 2 && !found; ++k) {
        float critical = k == 0 ? min(r0, r1) : max(r0, r1);
        if (!(critical > low && critical < 1.0)) continue;
        found = (evaluate(p, critical) >= 0.0) != above;
        if (found) high = critical; else low = critical;
      }
    }
    if (!found) {
      if (b3 == above) return -1.0;
      high = 1.0;
    }
  }
  // Take Newton steps that stay within the bracket.
  float s = 0.5 * (low + high);
  for (int k = 0; k < 20; ++k) {
    float value = evaluate(p, s);
    if ((value >= 0.0) == above) low = s; else high = s;
    float next = s - value / (p.y + s * (2.0 * p.z + s * 3.0 * p.w));
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (abs(next - s) < 1e-6) return next;
    s = next;
  }
  return high;
}

// Traverses bricks of 16^3 cells, in these bricks of 4^3, and in these cells.
Hit trace(Ray ray, float isovalue) {
  vec3 inverse;
  ivec3 forward;
  for (int a = 0; a < 3; ++a) {
    inverse[a] = ray.direction[a] != 0.0 ? 1.0 / ray.direction[a] : 0.0;
    forward[a] = ray.direction[a] > 0.0 ? 1 : 0;
  }
  float t = ray.t;
  ivec3 cell = clamp(ivec3(floor(ray.origin + t * ray.direction)), ivec3(0), dims - 2);
  ivec3 coarse = ivec3(NOWHERE), fine = ivec3(NOWHERE);
  int coarseSide = MIXED, fineSide = MIXED, state = UNKNOWN;
  for (int step = 0; step < 4096; ++step) {
    int size = 16, side;
    if (cell >> 4 != coarse) {
      coarse = cell >> 4;
      coarseSide = sideOf(coarseBounds, coarse, isovalue);
    }
    side = coarseSide;
    if (side == MIXED) {
      size = 4;
      if (cell >> 2 != fine) {
        fine = cell >> 2;
        fineSide = sideOf(bounds, fine, isovalue);
      }
      side = fineSide;
    }
    if (side == MIXED) size = 1;
    ivec3 low = (cell / size) * size;
    vec3 plane = vec3(low + forward * size);
    float leave = FAR_AWAY;
    int axis = 0;
    for (int a = 0; a < 3; ++a) {
      float at = ray.direction[a] != 0.0 ? (plane[a] - ray.origin[a]) * inverse[a] : FAR_AWAY;
      if (at < leave) leave = at, axis = a;
    }
    if (side == MIXED) {
      vec4 quadLow = quadAt(cell), quadHigh = quadAt(cell + ivec3(0, 0, 1));
      float most = largest(max(quadLow, quadHigh)), least = -largest(-min(quadLow, quadHigh));
      if (noData >= 0.0 && most >= noData) {
        side = UNKNOWN;
      } else if (least >= isovalue) {
        side = ABOVE;
      } else if (most < isovalue) {
        side = BELOW;
      } else {
        float end = min(leave, ray.end);
        if (end > t) {
          vec3 from = clamp(ray.origin + t * ray.direction - vec3(cell), 0.0, 1.0);
          vec3 to = clamp(ray.origin + end * ray.direction - vec3(cell), 0.0, 1.0);
          vec4 p = alongSegment(quadLow - isovalue, quadHigh - isovalue, from, to - from);
          if (state == UNKNOWN) state = p.x >= 0.0 ? ABOVE : BELOW;
          float s = firstCrossing(p, state == ABOVE);
          if (s >= 0.0) return Hit(t + s * (end - t), state == ABOVE);
        }
      }
    }
    if (side == UNKNOWN) {
      state = UNKNOWN;
    } else if (side != MIXED) {
      // If rounding put the face on another side, the crossing is on the face.
      if (state != UNKNOWN && state != side && leave > t) return Hit(t, state == ABOVE);
      state = side;
    }
    t = max(t, leave);
    if (!(t < ray.end)) break;
    ivec3 at = ivec3(floor(ray.origin + t * ray.direction));
    cell = clamp(at, low, min(low + size, dims - 1) - 1);
    cell[axis] = forward[axis] == 1 ? low[axis] + size : low[axis] - 1;
    if (cell[axis] < 0 || cell[axis] > dims[axis] - 2) break;
  }
  return Hit(-1.0, false);
}
