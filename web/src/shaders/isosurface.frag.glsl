// One isosurface of one volume, and a second, transparent one in front of it.

// Index coordinates: rays start at the eye; their directions are those of the picture's corner and
// so much more for each pixel. Not interpolated, since cards round the places of corners.
uniform vec3 eye, corner, right, up;
uniform mat4 indexToClip;
uniform float isovalue, secondIsovalue;  // in codes
uniform bool hasSecond;
uniform int result;  // 0: the picture, 1: fetches a pixel, 2: distances in lengths of the ray
uniform float opacity;  // of the second
uniform vec4 clip;      // index coordinates: what dot(clip, (p, 1)) < 0 is left out; 0 for none
uniform vec4 slices[3];  // planes that show the data, as `clip`
uniform vec3 colors[9];  // of the data, over the isovalues that are lit, as they are displayed
uniform vec3 tint[2];    // of the light of both isosurfaces

out vec4 color;

vec4 shown(vec3 radiance, float alpha) { return vec4(displayed(radiance) * alpha, alpha); }

float depthOf(vec3 place) {
  vec4 at = indexToClip * vec4(place, 1.0);
  return clamp(0.5 * at.z / at.w + 0.5, 0.0, 1.0);
}

vec3 colorOf(float value) {
  float at = 8.0 * clamp((value - isovalueRange.x) / (isovalueRange.y - isovalueRange.x), 0.0, 1.0);
  int low = min(int(at), 7);
  return mix(colors[low], colors[low + 1], at - float(low));
}

// Where the ray first hits data on a slice, FAR_AWAY for nowhere, and their value. Those below the
// isovalues that are lit, such as air, are left out.
float sliceAt(Ray ray, out float value) {
  float nearest = FAR_AWAY;
  value = -1.0;
  for (int k = 0; k < 3; ++k) {
    if (slices[k] == vec4(0.0)) continue;
    float t = -dot(slices[k], vec4(ray.origin, 1.0)) / dot(slices[k].xyz, ray.direction);
    if (!(t >= ray.t && t <= ray.end && t < nearest)) continue;
    float there = valueAt(ray.origin + t * ray.direction);
    if (there >= max(isovalueRange.x, 0.0)) nearest = t, value = there;
  }
  return nearest;
}

void main() {
  vec3 direction = corner + gl_FragCoord.x * right + gl_FragCoord.y * up;
  Ray ray = rayThroughBox(eye, direction);
  bool isCut = false;
  if (clip != vec4(0.0)) {
    float start = dot(clip, vec4(eye, 1.0)), rate = dot(clip.xyz, direction);
    float crossing = -start / rate;
    if (rate > 0.0) {
      isCut = crossing > ray.t;
      ray.t = max(ray.t, crossing);
    } else if (rate < 0.0) {
      ray.end = min(ray.end, crossing);
    } else if (start < 0.0) {
      ray.end = -1.0;
    }
  }
  Hit first = Hit(-1.0, false), second = Hit(-1.0, false);
  bool showsData = false;
  if (ray.t < ray.end) {
    float cutValue = isCut ? valueAt(ray.origin + ray.t * direction) : -1.0;
    float dataValue, slice = sliceAt(ray, dataValue);
    bool isOnCut = isCut && cutValue >= isovalue;
    if (isOnCut) {
      // What is cut open shows the data.
      slice = ray.t;
      dataValue = cutValue;
    } else {
      Ray before = ray;
      before.end = min(before.end, slice);
      first = trace(before, isovalue);
    }
    showsData = first.t < 0.0 && slice < FAR_AWAY;
    if (showsData) {
      first.t = slice;
      color = vec4(colorOf(dataValue), 1.0);
    }
    if (hasSecond && !isOnCut) {
      Ray before = ray;
      if (first.t >= 0.0) before.end = first.t;
      if (!isCut || cutValue < secondIsovalue) second = trace(before, secondIsovalue);
    }
  }
  // One place that calls it, since drivers copy it to each.
  Hit hits[2] = Hit[2](first, second);
  vec3 radiance[2];
  for (int k = 0; k < 2; ++k) {
    if (hits[k].t < 0.0 || (k == 0 && showsData)) continue;
    float own = k == 0 ? isovalue : secondIsovalue;
    radiance[k] = tint[k] * light(eye + hits[k].t * direction, hits[k], own, k);
  }
  if (result == 1) {
    color = vec4(float(fetches & 255) / 255.0, float(fetches >> 8) / 255.0, 0.0, 1.0);
    gl_FragDepth = 0.0;
    return;
  }
  if (first.t < 0.0 && second.t < 0.0) discard;
  if (result == 2) {
    float t = second.t >= 0.0 ? second.t : first.t;
    color = vec4((uvec4(floatBitsToUint(t)) >> uvec4(0, 8, 16, 24)) & 255u) / 255.0;
    gl_FragDepth = depthOf(eye + t * direction);
    return;
  }
  if (first.t < 0.0) color = vec4(0.0);
  if (first.t >= 0.0 && !showsData) color = shown(radiance[0], 1.0);
  if (second.t >= 0.0) {
    vec4 before = shown(radiance[1], opacity);
    color = before + (1.0 - opacity) * color;
  }
  gl_FragDepth = depthOf(eye + (first.t >= 0.0 ? first.t : second.t) * direction);
}
