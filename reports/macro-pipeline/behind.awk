# How many times as much the FIFO behind P1 would have to hold as the one behind P2.
BEGIN { print "scene,order,behind_p1,behind_p2,times" }
{ print at("scene"), at("order"), at("behind_p1"), at("behind_p2"), sprintf("%.2f", at("behind_p1") / at("behind_p2")) }
