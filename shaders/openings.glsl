// The first probe of a view's rays: all choose from one point, so that the corners of its cell are looked at once for a
// view (find_openings.comp) and a ray reads what they have come to.

// 0: every ray looks at the corners itself. The answers are the same bits.
layout(constant_id = 16) const int kSharedOpenings = 0;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Openings { CandidatePlace v[]; };

// No probe, where none is resident at the cell or the ray is to look itself.
RayHint opening_hint(uvec2 address, int view, vec3 direction) {
  RayHint hint = no_hint();
  if (kSharedOpenings != 0) {
    float best = -PW_NEVER;
    PW_UNROLL for (int k = 0; k < PW_CANDIDATES; ++k) {
      CandidatePlace place = Openings(address).v[view * PW_CANDIDATES + k];
      float score = candidate_score(place, kRuleFirst, direction);
      hint.probe = score > best ? place.probe : hint.probe;
      best = max(score, best);
    }
  }
  return hint;
}
