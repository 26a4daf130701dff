// air.glsl - the air of a planet.
const float AIR_THICKNESS = 0.00125; // height by which it thins e-fold, of the radius
