// Radiance of the sun, mirrored by a clear surface: GGX with Smith's joint visibility, without the Fresnel term.
float sun_mirrored(vec3 normal, vec3 to_eye, float roughness) {
  vec3 halfway = normalize(frame.to_sun.xyz + to_eye);
  float nl = max(dot(normal, frame.to_sun.xyz), 0.0), nv = max(dot(normal, to_eye), 1e-3);
  float nh = max(dot(normal, halfway), 0.0);
  float a2 = max(pow(roughness, 4.0), 1e-5);
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-5);
  return frame.to_sun.w * nl * visibility * a2 / (pi * d * d);
}
