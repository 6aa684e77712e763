"""How the network of LBF is trained: scenes, samples, the objective with its gradient, and the command."""
