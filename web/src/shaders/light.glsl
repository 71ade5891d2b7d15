// The light at a point of an isosurface: baked, or by local shading.

const int MOST = 8;  // isosurfaces that are shown together

uniform sampler3D front, back;  // bricks of radiance times the exposure of the scene
uniform usampler3D table;        // position of each brick
uniform ivec3 brick, bricks;     // texels of a brick, including shared layers; numbers of bricks
uniform vec3 texelScale, textureScale;  // index coordinates to texels; inverse size of textures
uniform int layers;              // of texels on the cap of a cut, above the others along z
uniform float layerHeight;       // texels along z
uniform vec2 layerCodes;         // middle of the first layer, and their step
uniform int backIs;         // 0: baked, 1: dark, 2: lit from the camera
uniform float unbaked;  // brightness of a white one (2) that faces the viewer
uniform bool isLocal;
uniform bool backHasMaps;  // false: texels of the back hold all light
// Materials of each isosurface: factor of another albedo (tint), gloss and roughness (coats).
uniform vec3 albedo[MOST], emission[MOST], tint[MOST];
uniform vec2 coats[MOST];
uniform vec3 indirectFactor;          // growth of indirect light with the lamps
#ifdef TEXTURE
uniform sampler3D pigment;  // colors that multiply the albedo
uniform mat4 toPigment;     // index coordinates to those of the texture
uniform vec3 pigmentMargin;  // by which these are valid below 0 and above 1
#endif

// Returns the color by which another volume multiplies the albedo.
vec3 pigmentAt(vec3 place) {
#ifdef TEXTURE
  fetches += 1;
  vec3 at = (toPigment * vec4(place, 1.0)).xyz;
  vec3 outside = max(-at, at - 1.0);
  if (all(lessThanEqual(outside, pigmentMargin))) return texture(pigment, at).rgb;
#endif
  return vec3(1.0);
}

// Returns the radiance of the texels around a position, or that of one of their layers.
vec3 ofLayer(vec3 place, bool isBack, int layer) {
  fetches += 2;
  vec3 texel = max(place * texelScale, 0.0);
  texel.z += float(layer) * layerHeight;
  ivec3 within = min(ivec3(texel) / (brick - 1), bricks - 1);
  uvec4 entry = texelFetch(table, within, 0);
  if (entry.w == 0u) return vec3(0.0);
  vec3 first = vec3(entry.xyz) * vec3(brick);
  vec3 at = (first + texel - vec3(within * (brick - 1)) + 0.5) * textureScale;
  return isBack ? texture(back, at).rgb : texture(front, at).rgb;
}

vec3 ofTexels(vec3 place, bool isBack) {
  return ofLayer(place, isBack, 0);
}

#ifdef CUTS
// Returns the radiance of the isosurface on a cap, between two layers.
vec3 ofCap(vec3 place, float isovalue, bool isBack) {
  float layer = clamp((isovalue - layerCodes.x) / layerCodes.y, 0.0, float(layers - 1));
  int below = min(int(layer), layers - 2);
  vec3 low = ofLayer(place, isBack, below + 1), high = ofLayer(place, isBack, below + 2);
  return mix(low, high, layer - float(below));
}
#endif

#ifdef DIRECT
bool isLit(vec3 place) {
  if (any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(dims - 1)))) return false;
  float value = valueAt(place);
  return value >= max(isovalueRange.x, 0.0) && value <= isovalueRange.y;
}

// Returns indirect light, as core/src/bake/output/radiance_grid.cpp. It is extrapolated from texels
// in front, if isosurfaces there are parallel to the one at the point. Otherwise it is that of
// texels around the point.
vec3 indirectLight(vec3 place, vec3 gradient, float isovalue, bool isBack) {
#ifdef CUTS
  if (layers > 0 && gradientOnCut(place, isovalue).w == 1.0) return ofCap(place, isovalue, isBack);
#endif
  float size = length(gradient * texelScale);
  if (size == 0.0) return ofTexels(place, isBack);
  vec3 ahead = gradient * ((isBack ? 0.5 : -0.5) / size);
  vec3 near = place + ahead, far = near + 2.0 * ahead;
  if (!isLit(near) || !isLit(far)) return ofTexels(place, isBack);
  vec3 distantGradient = gradientAt(far, valueAt(far));
  float square = max(dot(gradient, gradient), dot(distantGradient, distantGradient));
  float like = smoothstep(0.0, 1.0, dot(gradient, distantGradient) / square);
  vec3 close = ofTexels(near, isBack), distant = ofTexels(far, isBack);
  vec3 inFront = clamp(close + 0.5 * (close - distant), 0.5 * close, 2.0 * close);
  return mix(ofTexels(place, isBack), inFront, like);
}
#endif

// Returns the light of an isosurface by its number.
vec3 light(vec3 place, Hit hit, float isovalue, int number) {
  vec3 color = tint[number] * pigmentAt(place);
  if (!isLocal && !(hit.fromInside && backIs != 0)) {
#ifdef DIRECT
    if (hit.fromInside && !backHasMaps) return color * ofTexels(place, true);
    vec3 gradient = gradientAt(place, isovalue);
    DirectLight direct = directLight(place, gradient, isovalue, hit.fromInside, coats[number]);
    vec3 own = exposure * emission[number];
    vec3 others = indirectLight(place, gradient, isovalue, hit.fromInside) - own;
    vec3 radiance = max(own + others * indirectFactor, 0.0);
    radiance += exposure / PI * albedo[number] * direct.irradiance;
    return color * radiance + exposure * direct.reflected;
#else
    return color * ofTexels(place, hit.fromInside);
#endif
  }
  if (!isLocal && backIs == 1) return vec3(0.0);
  vec3 normal = -normalize(normalToWorld * gradientAt(place, isovalue));
  if (hit.fromInside) normal = -normal;
  vec3 world = (indexToWorld * vec4(place, 1.0)).xyz;
  if (!isLocal) return unbaked * color * albedo[number] * headlight(world, normal);
  return exposure * (color * albedo[number] * irradianceOverPi(world, normal) + emission[number]);
}
