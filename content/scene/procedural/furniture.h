// Furniture and fittings of the sample house. Each piece is drawn into the brush's object, standing on y = 0
// of its frame, centred in x and z, its front towards +z; sizes in metres.
#pragma once

#include "content/scene/procedural/brush.h"
#include "content/scene/procedural/palette.h"

namespace probewalk::procedural {

// Seating
void draw_sofa(Brush brush, const Palette& p, double width);
void draw_armchair(Brush brush, const Palette& p, MaterialId cloth);
void draw_chair(Brush brush, const Palette& p, MaterialId wood);  // legs 2.6 cm thin, slatted back
void draw_stool(Brush brush, const Palette& p, double height);    // four splayed rods
void draw_bench(Brush brush, const Palette& p, MaterialId wood, double width);

// Tables
void draw_table(Brush brush, MaterialId top, MaterialId legs, double width, double depth, double height);
void draw_round_table(Brush brush, MaterialId top, MaterialId leg, double radius, double height);
void draw_coffee_table(Brush brush, const Palette& p);  // glossy top on a thin frame
void draw_desk(Brush brush, const Palette& p);          // with drawers, lamp and papers left to the room

// Storage
void draw_bookcase(Brush brush, const Palette& p, MaterialId wood, double width, double height, int seed);
void draw_wall_shelf(Brush brush, const Palette& p, double width,
                     int seed);  // y = 0 is the shelf's underside
void draw_books(Brush brush, const Palette& p, double width, double max_height, double depth,
                int seed);  // a standing row
void draw_book_pile(Brush brush, const Palette& p, int count, int seed);
void draw_sideboard(Brush brush, const Palette& p, MaterialId wood, double width);
void draw_wardrobe(Brush brush, const Palette& p, double width);
void draw_clothes_rail(Brush brush, const Palette& p, double width);
void draw_nightstand(Brush brush, const Palette& p);
void draw_fireplace(Brush brush, const Palette& p);

// Kitchen and bath
void draw_counter(Brush brush, const Palette& p, double width, bool sink, bool hob);
void draw_wall_cabinet(Brush brush, const Palette& p, double width);  // y = 0 is its underside
void draw_fridge(Brush brush, const Palette& p);
void draw_bathtub(Brush brush, const Palette& p);
void draw_washstand(Brush brush, const Palette& p);
void draw_toilet(Brush brush, const Palette& p);

// Beds
void draw_double_bed(Brush brush, const Palette& p);  // head at -z
void draw_single_bed(Brush brush, const Palette& p);

// Small things
void draw_rug(Brush brush, MaterialId rug, MaterialId edge, double width, double depth);
void draw_painting(Brush brush, MaterialId painting, MaterialId frame, double width,
                   double height);  // centre, wall at z = 0
void draw_curtain(Brush brush, const Palette& p, double width, double height,
                  double folds);  // a single-layer sheet below its rod
void draw_curtain_rod(Brush brush, const Palette& p, double width);
void draw_vase(Brush brush, MaterialId clay, double height);
void draw_fruit_bowl(Brush brush, const Palette& p);
void draw_tableware(Brush brush, const Palette& p);  // plate and cup for one
void draw_candle(Brush brush, const Palette& p, double height);

// Lamps: glowing shades, and a point or spot light of so many candela for each
void draw_floor_lamp(Brush brush, const Palette& p, double candela);
void draw_table_lamp(Brush brush, const Palette& p, double candela);
void draw_pendant(Brush brush, const Palette& p, double drop, double candela);  // hangs down from y = 0
void draw_globe_pendant(Brush brush, const Palette& p, double drop, double radius, double candela);
void draw_ceiling_lamp(Brush brush, const Palette& p, double candela);  // disc under y = 0
void draw_reading_spot(Brush brush, const Palette& p, double candela);  // desk lamp with a spot light

}  // namespace probewalk::procedural
