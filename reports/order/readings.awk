# Times against those of the standard machine.
BEGIN { print "scene,order,cells,reading,us_per_ray,times_as_long" }
at("us_per_ray") == "" || at("partition") != "work" { next }
{
    o = at("order"); sub(/:1$/, "", o)
    reading = FILENAME; sub(/\.csv$/, "", reading)
    name = at("scene") "," o "," at("cells")
}
reading == "cells" { standard[name] = at("us_per_ray"); next }
name in standard { print name "," reading sprintf(",%.2f,%.4f", at("us_per_ray"), at("us_per_ray") / standard[name]) }
