// The second eye's rays from what the first one has seen. Both eyes look the same way from two places on the pictures'
// horizontal, so that all points of a second eye's ray lie on one row of the first one's picture: from where the ray's
// end would be, x_far, to x_far + pixels_m / depth. The ray is gone along in that picture from its near end on, until it
// is no longer in front of what was seen there. Where the pixels on either side of that place have seen one plane, the ray
// meets that plane, and no probe needs to be walked through.
//
// Beyond the right edge of its picture the first eye looks once a tile: whatever might be close to the second one there
// makes it trace its rays.
//
// What can be wrong: whatever is narrower than the first eye's pixels, whatever it could not see since it is closer than
// kUnseen_m and outside its picture, and radiance that another probe would have shown.

// Metres from the eye within which nothing is expected that the other one's picture has not got.
const float kUnseen_m = 0.1;
// By how much the eyes' axes and the tangents of their pictures' upper and lower edges may differ, as runtimes round them:
// some hundredths of a headset's pixel.
const float kAlike = 1e-5;
// Least depth kept, so that none is 0, and that of the sky.
const float kSeenNear_m = 1e-4;
const float kSeenFar_m = 1e30;
// Two pixels have seen one plane where both put the hit at the same distance, relatively.
const float kSamePlane = 1e-4;
// Pixels beside the last one that a ray was in front of, from where on it has to be traced.
const float kFreeFrom_px = 1.5;
// Pixels by which rounding may put a hit beside the two pixels that it lies between.
const float kBeside_px = 0.02;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SeenSurfaces { SeenSurface v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SeenDepths { float v[]; };

int seen_columns(ivec2 size_px) { return (size_px.x + kSeenTile - 1) / kSeenTile; }

// Of a row of tiles, the place of its first depth; its margin's lie behind its tiles'.
int seen_row(int pair, int row, ivec2 size_px) {
  int rows = (size_px.y + kSeenTile - 1) / kSeenTile, columns = seen_columns(size_px);
  return (pair * rows + row) * (columns + seen_margin(columns));
}

// Pixels to the right that a point one metre away is in the first eye's picture; not above 0: the eyes are not side by
// side, or not as their pictures' order says, and each has to look for itself.
float eye_pixels_m(ViewConstants first, ViewConstants second, ivec2 size_px) {
  vec3 apart = (second.origin_hi_m - first.origin_hi_m) + (second.origin_lo_m - first.origin_lo_m);
  float across = dot(apart, first.world_from_eye_x.xyz);
  float up = dot(apart, first.world_from_eye_y.xyz), back = dot(apart, first.world_from_eye_z.xyz);
  vec3 off_x = abs(first.world_from_eye_x.xyz - second.world_from_eye_x.xyz);
  vec3 off_y = abs(first.world_from_eye_y.xyz - second.world_from_eye_y.xyz);
  vec3 off = max(max(off_x, off_y), vec3(abs(first.tan_angles.zw - second.tan_angles.zw), 0.0));
  bool alike = max(max(off.x, off.y), off.z) <= kAlike;
  bool level = abs(up) + abs(back) <= 1e-4 * abs(across);
  return alike && level ? across * float(size_px.x) / (first.tan_angles.y - first.tan_angles.x) : -1.0;
}

// Where on its row of the first eye's picture, in pixels from the first one's centre, the far end of the second eye's
// ray through column x is.
float far_column(ViewConstants first, ViewConstants second, float x, ivec2 size_px) {
  float along = second.tan_angles.x + (x + 0.5) / float(size_px.x) * (second.tan_angles.y - second.tan_angles.x);
  return (along - first.tan_angles.x) / (first.tan_angles.y - first.tan_angles.x) * float(size_px.x) - 0.5;
}

int seen_pixel(ivec3 texel, ivec2 size_px) { return (texel.z / 2 * size_px.y + texel.y) * size_px.x + texel.x; }
