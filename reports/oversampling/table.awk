BEGIN { print "size,by,samples,primary,primary_hit,shadow,shadow_blocked,rays,oversampled,share,times_the_rays,relative_time" }
at("by") == "none" { cycles = at("cycles"); pixels = at("samples"); rays = at("rays") }
{
    print at("size"), at("by"), at("samples"), at("primary"), at("primary_hit"), at("shadow"), at("shadow_hit"), at("rays"), at("refined"), \
        sprintf("%.3f,%.2f,%.2f", at("refined") / pixels, at("rays") / rays, at("cycles") / cycles)
}
