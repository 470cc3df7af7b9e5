"""latent-farm: plans, submits and watches a render on many machines. It runs the other tools and reads their --json; docs/farm.md."""
