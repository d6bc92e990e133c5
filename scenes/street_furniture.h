// What stands on pavements: benches, bicycle racks, bicycles, street lamps. All stand on y = 0 around the origin.
#pragma once

#include "scenes/scene.h"

namespace gnomon::scenes {

/// A park bench 1.8 m wide along x whose seat faces +z: slats with narrow gaps on two iron frames.
void append_bench(Mesh& wood, Mesh& iron);

/// One hoop of a bicycle rack in the plane z = 0: a tube of 4.8 cm, 0.76 m wide, 0.88 m high.
void append_rack_hoop(Mesh& steel);

/// A bicycle 1.7 m long in the plane z = 0, its front towards +x.
void append_bicycle(Mesh& paint, Mesh& rubber);

/// A street lamp 6.6 m high whose arm reaches 2.1 m towards +x.
void append_street_lamp(Mesh& steel);

}  // namespace gnomon::scenes
