// Draws the isosurfaces of one volume that are shown together.

// Index coordinates. Rays start at the eye. Their direction is that of the picture's corner plus
// these vectors for each pixel. It is not interpolated, because graphics cards round positions of
// vertices.
uniform vec3 eye, corner, right, up;
uniform mat4 indexToClip;
uniform int count;
uniform float isovalues[MOST];  // codes; cuts show data above the first isovalue
uniform float opacities[MOST];
uniform int result;  // 0: picture, 1: fetches per pixel, 2: distances in ray lengths
uniform vec4 clip;      // points with dot(clip, (p, 1)) < 0 are cut away; 0 for none
uniform vec4 slices[3];  // planes that show the data, like `clip`
uniform vec3 colors[9];  // displayed colors of the data, over the lit isovalues

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

// Returns the first hit of the ray on data in a slice, FAR_AWAY for none, and the value. Data below
// the lit isovalues, such as air, are skipped.
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
  float slice = FAR_AWAY, dataValue = -1.0, nearest = FAR_AWAY, farthest = -1.0;
  Hit hits[MOST];
  if (ray.t < ray.end) {
    float cutValue = isCut ? valueAt(ray.origin + ray.t * direction) : -1.0;
    slice = sliceAt(ray, dataValue);
    bool isOnCut = isCut && cutValue >= isovalues[0];
    if (isOnCut) slice = ray.t, dataValue = cutValue;
    ray.end = min(ray.end, slice);
    for (int k = 0; k < count; ++k) {
      hits[k] = Hit(-1.0, false);
      if (isOnCut || (k > 0 && isCut && cutValue >= isovalues[k])) continue;
      hits[k] = trace(ray, isovalues[k]);
      if (hits[k].t < 0.0) continue;
      nearest = min(nearest, hits[k].t);
      // Stop at an opaque isosurface.
      if (opacities[k] == 1.0) ray.end = min(ray.end, hits[k].t);
    }
  } else {
    for (int k = 0; k < count; ++k) hits[k] = Hit(-1.0, false);
  }
  nearest = min(nearest, slice);
  // Sort hits from the nearest to the farthest.
  color = vec4(0.0);
  bool isDone[MOST];
  for (int k = 0; k < count; ++k) isDone[k] = hits[k].t < 0.0;
  for (int layer = 0; layer < count && color.a < 0.99; ++layer) {
    int next = -1;
    for (int k = 0; k < count; ++k) {
      if (!isDone[k] && (next < 0 || hits[k].t < hits[next].t)) next = k;
    }
    if (next < 0 || hits[next].t > slice) break;
    isDone[next] = true;
    Hit hit = hits[next];
    farthest = hit.t;
    vec3 radiance = light(eye + hit.t * direction, hit, isovalues[next], next);
    color += (1.0 - color.a) * shown(radiance, opacities[next]);
  }
  if (slice < FAR_AWAY && color.a < 0.99) {
    farthest = slice;
    color += (1.0 - color.a) * vec4(colorOf(dataValue), 1.0);
  }
  if (result == 1) {
    color = vec4(float(fetches & 255) / 255.0, float(fetches >> 8) / 255.0, 0.0, 1.0);
    gl_FragDepth = 0.0;
    return;
  }
  if (nearest == FAR_AWAY) discard;
  if (result == 2) {
    color = vec4((uvec4(floatBitsToUint(nearest)) >> uvec4(0, 8, 16, 24)) & 255u) / 255.0;
    gl_FragDepth = depthOf(eye + nearest * direction);
    return;
  }
  gl_FragDepth = depthOf(eye + farthest * direction);
}
