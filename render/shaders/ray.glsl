// From the eye through a place on screen, in the world; not normalised: its part along the view is 1.
vec3 world_ray(vec2 place) {
  vec4 far = frame.inverse_projection * vec4(2.0 * place - 1.0, 1.0, 1.0);
  return mat3(frame.inverse_view) * (far.xyz / -far.z);
}

// Where the surface is that was drawn at this place with this value in the depth buffer.
vec3 world_of_depth(vec2 place, float depth) {
  vec4 view = frame.inverse_projection * vec4(vec3(place, depth) * 2.0 - 1.0, 1.0);
  return (frame.inverse_view * vec4(view.xyz / view.w, 1.0)).xyz;
}
