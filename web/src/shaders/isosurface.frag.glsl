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

out vec4 color;

vec4 shown(vec3 radiance, float alpha) { return vec4(displayed(radiance) * alpha, alpha); }

float depthOf(vec3 place) {
  vec4 at = indexToClip * vec4(place, 1.0);
  return clamp(0.5 * at.z / at.w + 0.5, 0.0, 1.0);
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
  bool isOnCut = false;
  if (ray.t < ray.end) {
    float cutValue = isCut ? valueAt(ray.origin + ray.t * direction) : -1.0;
    isOnCut = isCut && cutValue >= isovalue;
    if (isOnCut) {
      // What is cut open shows the data, as gray.
      first.t = ray.t;
      float gray = clamp((cutValue - window.x) / (window.y - window.x), 0.0, 1.0);
      color = vec4(vec3(0.15 + 0.7 * gray), 1.0);
    } else {
      first = trace(ray, isovalue);
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
    if (hits[k].t < 0.0 || (k == 0 && isOnCut)) continue;
    float own = k == 0 ? isovalue : secondIsovalue;
    radiance[k] = light(eye + hits[k].t * direction, hits[k], own, k);
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
  if (first.t >= 0.0 && !isOnCut) color = shown(radiance[0], 1.0);
  if (second.t >= 0.0) {
    vec4 before = shown(radiance[1], opacity);
    color = before + (1.0 - opacity) * color;
  }
  gl_FragDepth = depthOf(eye + (first.t >= 0.0 ? first.t : second.t) * direction);
}
