"""The site: pages gathered from the repository, pages made from results, and their build."""
