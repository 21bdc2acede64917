BEGIN { print "scene,program,cells,words_a_ray,us_per_ray,mbyte_a_second,link_used" }
{
    words = at("busiest_link_words") / at("ray_count"); rate = 4 * words / at("us_per_ray")
    print at("scene"), at("program"), at("cells"), sprintf("%.1f,%.1f,%.3f,%.4f", words, at("us_per_ray"), rate, rate / 80)
}
