BEGIN { print "scene,partition,cells,cause,share" }
{
    split("efficiency floor extra moving imbalance in_step", names, " ")
    for (i = 1; i <= 6; i++) print at("scene"), at("partition"), at("cells"), names[i], at(names[i])
}
