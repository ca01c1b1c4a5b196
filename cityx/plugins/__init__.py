"""Every action, one file per module, in folders by stage."""
