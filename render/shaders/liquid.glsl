// Functions shared by the shaders of liquids.

// Edge of a pixel at this depth along the view. [m]
float pixel_size(float depth) {
  return 2.0 * frame.size.w / frame.projection[1][1] * (frame.projection[3][3] == 1.0 ? 1.0 : depth);
}

// Added to depths from the sun: the filters average 1 / depth, which is nearly linear far from the eye. [m]
float sun_offset() { return -8.0 / frame.projection[2][2]; }

// View depth of the opaque objects, from the depth buffer; very large where there are none.
float opaque_depth(float buffer) {
  return buffer < 1.0 ? frame.projection[3][2] / (2.0 * buffer - 1.0 + frame.projection[2][2]) : 1e30;
}
