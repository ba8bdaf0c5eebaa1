// Reflected fraction of unpolarized light at a surface (Fresnel), which is 1 beyond the critical angle.
float fresnel(float cosine, float index) {
  float square = index * index - 1.0 + cosine * cosine;
  if (square <= 0.0) return 1.0;
  float g = sqrt(square);
  float a = (g - cosine) / max(g + cosine, 1e-4);
  float b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
  return min(0.5 * a * a * (1.0 + b * b), 1.0);
}
