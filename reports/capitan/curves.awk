# The smaller image's times, to be drawn: published and simulated.
BEGIN { print "times,workers,seconds" }
at("size") == "100x100" {
    print (FILENAME == "published.csv" ? "published" : "simulated"), at("workers"), at("seconds")
}
