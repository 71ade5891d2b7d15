// The clear coat of glossy looks, which reflects the lamps.

struct Coat {
  float weight;  // 0: no coat
  float width;   // width of the highlight
  vec3 toEye;
};

// Returns the coat. Schlick's reflectance (1994) for an index of 1.8, as in the add-on.
Coat coatAt(vec3 place, vec3 normal, vec2 coat) {
  // Lamps are sets of points. A smoother coat would show each point.
  const float LEAST_WIDTH = 0.06;
  vec3 toEye = normalize(worldEye - place);
  float grazing = pow(1.0 - abs(dot(toEye, normal)), 5.0);
  return Coat(coat.x * (0.08 + 0.92 * grazing), max(coat.y * coat.y, LEAST_WIDTH), toEye);
}

// Returns the factor from irradiance to reflected radiance: GGX (Walter et al. 2007), with the
// visibility of Hammon (2017).
float reflectance(Coat coat, vec3 normal, vec3 toLight) {
  float squared = coat.width * coat.width;
  float between = dot(normal, normalize(toLight + coat.toEye));
  float lobe = 1.0 + between * between * (squared - 1.0);
  float toward = max(dot(normal, toLight), 0.0), back = max(dot(normal, coat.toEye), 1e-3);
  float visible = 0.5 / mix(2.0 * toward * back, toward + back, coat.width);
  return coat.weight * visible * squared / (PI * lobe * lobe);
}
