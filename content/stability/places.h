// Where the hard cases happen: one probe each, baked from a small scene or made to hold what no scene holds.
#pragma once

#include <memory>
#include <string>

#include "content/probe/brute_force.h"
#include "content/probe/device_probe.h"
#include "content/probe/probe_map.h"

namespace probewalk::stability {

enum class PlaceId {
  kRoom,      // a furnished room with a window
  kGrille,    // 2 cm bars every 12 cm: cuts everywhere
  kLeaves,    // foliage all around, from 5 cm on
  kRoomFine,  // room and grille at 512 cells a side
  kGrilleFine,
  kTiny,    // the room, one millimetre wide: every sample scaled
  kVast,    // the room, ten kilometres wide
  kFarOut,  // the room, 1e5 m from the scene's origin
  kPlain,   // things from 1 m on, walls at 1e4 m
  kSky,     // nothing anywhere
  kSolid,   // a probe inside a pillar
  kLeast,   // packs' limits: samples of the least and the greatest w, and sky, at random
  kSteps,   // the room's samples rounded to 65535 steps of the greatest
  kQuantised,        // room and grille as packs with quantised samples hold them
  kQuantisedGrille,
  kQuantisedLimits,  // tiles of quantised samples at their limits: one value, a float's last bit, least and greatest
                     // beside sky, the largest code, planes down to the least w
  kTorn,    // every edge cut, at the first or the last fraction, every slope at its clamp or random
};

struct Place {
  std::string name;
  double scale_m = 1.0;  // what counts as a metre here
  // The geometry's position is where the probe is in the world; rays are made relative to it.
  ProbeGeometry geometry;
  DeviceProbe device;
  ProbeRecord record;  // points into `device`
  BruteForceProbe brute;
};

std::string place_name(PlaceId id);
int place_cells(PlaceId id);  // a side
// Takes up to a second or so. The same every time.
std::unique_ptr<Place> make_place(PlaceId id);

}  // namespace probewalk::stability
