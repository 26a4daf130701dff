// globe.glsl - what fragments of all surfaces of globes go by.
#ifdef NORMALS
#ifdef FINE_NORMALS
const float UPRIGHT = 1e-4; // of a normal's length, squared, that is told from none
#else
const float UPRIGHT = 0.01;
#endif
#endif

// Unit, in the eye's axes: east, north, up.
vec3 view_ray()
{
    return normalize(pixel[2].xyz + (gl_FragCoord.x * lens.x / lens.z - 1.0) * pixel[0].xyz +
                     (gl_FragCoord.y * lens.y / lens.w - 1.0) * pixel[1].xyz);
}

#ifdef HAZE
// Squared optical depth of the way through air that thins out with height: to the terrain, or from where the air begins.
// up: the ground's; height: metres above z_base.
float air_before(float nearness, vec3 up, float height)
{
    float radius = body_radius(), thickness = AIR_THICKNESS * radius;
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    vec3 view = view_ray();
    float away = haze.w / nearness * sqrt(1.0 + dot(across, across));
    float steep = max(-dot(view, up), 0.0), path = min(away, thickness / (steep + 0.035));
    float depth = path / (0.018 * radius) * exp(-max(height - heights.x, 0.0) / thickness);
    return depth * depth;
}
#endif
