"""Training of LBF's network: scenes, samples, the objective with its gradient, and the command."""
