BEGIN { print "cells,cells_run,us_per_ray,rays_per_second" }
{ print at("cells"), at("cells_run"), sprintf("%.2f,%.0f", at("us_per_ray"), at("rays_per_second")) }
