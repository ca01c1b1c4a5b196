"""Where trees and plants stand, and which."""
