// The light of a point on an isosurface: of the bake, or by lamps alone.

uniform sampler3D outer, inner;  // bricks of radiance times the exposure of the scene
uniform usampler3D table;        // where in these each brick is
uniform ivec3 brick, bricks;     // texels of a brick, with the layers that it shares; their numbers
uniform vec3 texelScale, textureScale;  // from index coordinates to texels; one over the textures'
uniform int innerIs;    // 0: baked, 1: dark, 2: to be shaded by a light at the camera
uniform float unbaked;  // how bright such a side is that is white and faces the viewer
uniform bool isLocal;
uniform mat4 indexToWorld;
uniform vec3 albedo[2], emission[2];  // of both isosurfaces

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
  if (!isLocal) return unbaked * albedo[number] * headlight(world, normal);
  return exposure * (albedo[number] * irradianceOverPi(world, normal) + emission[number]);
}
