// globe.glsl - what fragments of all surfaces of globes go by.
#ifdef NORMALS
#ifdef FINE_NORMALS
const float UPRIGHT = 1e-4; // of a normal's length, squared, that is told from none
#else
const float UPRIGHT = 0.01;
#endif
#endif

// From the eye, in its axes: east, north, up. 1 along the view's axis.
vec3 view_ray()
{
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    return pixel[2].xyz + across.x * pixel[0].xyz + across.y * pixel[1].xyz;
}

#ifdef HAZE
// Squared optical depth of the way through air that thins out with height: to the terrain, or from where the air begins.
// up: the ground's; height: metres above z_base.
float air_before(float nearness, vec3 up, float height)
{
    float radius = body_radius(), per_radius = 1.0 / radius;
    vec3 view = view_ray();
    float long2 = dot(view, view), per_long = inversesqrt(long2);
    float away = haze.w / nearness * (long2 * per_long);
    float steep = max(-dot(view, up) * per_long, 0.0), path = min(away, AIR_THICKNESS * radius / (steep + 0.035));
    float depth = path * per_radius / 0.018 * exp(-max(height - heights.x, 0.0) * per_radius / AIR_THICKNESS);
    return depth * depth;
}
#endif
