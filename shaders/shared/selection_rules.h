// Which probe a ray asks first, which next, and from where: the thesis's choices (chapters 5 and 6) and ours. On the
// device they are specialisation constants, so that no scene pays for a rule it does not use.
#ifndef PROBEWALK_SHADERS_SHARED_SELECTION_RULES_H
#define PROBEWALK_SHADERS_SHARED_SELECTION_RULES_H

#include "dialect.h"

PW_SHARED_BEGIN

// The first probe of a cell's eight: the nearest; the one that the ray runs most nearly straight away from (signed
// cosine, thesis 5.7), or away from or towards (unsigned, algorithm 6); or the signed cosine less distance_weight times
// the distance over the cell's diagonal.
PW_CONSTANT int kFirstNearest = 0;
PW_CONSTANT int kFirstSigned = 1;
PW_CONSTANT int kFirstUnsigned = 2;
PW_CONSTANT int kFirstSignedLessDistance = 3;

// The others of the eight: by falling score; corner + 3 mod 8 (thesis 5.5); or the order whose neighbours' numbers have
// the greatest sum of exclusive ors around the circle, first ^ (0 5 2 4 3 6 1 7): 50, of which + 3 mod 8 reaches 40.
PW_CONSTANT int kOrderSorted = 0;
PW_CONSTANT int kOrderPlusThree = 1;
PW_CONSTANT int kOrderMaximalXor = 2;

// What a ray that no probe resolves is answered with (its class stays unknown): nothing (black); the surface nearest to
// the point where the knowledge ends, if one is plausible there, else the light from its direction; or always the latter.
PW_CONSTANT int kLastResortNothing = 0;
PW_CONSTANT int kLastResortStopPoint = 1;
PW_CONSTANT int kLastResortEnvironment = 2;

struct SelectionRules {
  pw_int first;        // kFirst...
  pw_int order;        // kOrder...
  pw_int advance;      // 1: candidates come from the cell of the current point and of points ahead; 0: the origin's alone
  pw_int retry;        // 1: a probe that failed is asked again once the ray is known to be free further on
  pw_int start_test;   // 1: probes that cannot see the current point are passed over
  pw_int hand_on;      // 1: a probe goes on from where the last one's knowledge ended (algorithm 5); 0: every probe starts
                       // at the ray's origin (algorithm 4), and none is asked twice
  pw_int last_resort;  // kLastResort...
  // Probes are chosen as for a ray from its origin moved by this. A head's two eyes choose as its middle would: what both
  // see then comes from one probe more often.
  pw_vec3 choice_shift_m;
};

// What the product traces with (design: fewer-tries, 1).
PW_FUNCTION SelectionRules default_rules() {
  SelectionRules rules;
  rules.first = kFirstSignedLessDistance;
  rules.order = kOrderSorted;
  rules.advance = 1;
  rules.retry = 1;
  rules.start_test = 1;
  rules.hand_on = 1;
  rules.last_resort = kLastResortStopPoint;
  rules.choice_shift_m = pw_vec3(0.0f);
  return rules;
}

PW_SHARED_END

#endif
