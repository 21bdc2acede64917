BEGIN { print "by,samples,primary,primary_hit,shadow,shadow_blocked,oversampled,share,relative_time,mean_square" }
at("by") == "none" { cycles = at("cycles"); pixels = at("samples") }
{
    print at("by"), at("samples"), at("primary"), at("primary_hit"), at("shadow"), at("shadow_hit"), at("refined"), \
        sprintf("%.3f,%.2f,%.3f", at("refined") / pixels, at("cycles") / cycles, at("mean_square"))
}
