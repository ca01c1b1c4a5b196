"""Learn to drive in made towns, and drive in places that were never seen: PPO in one file.

    python training/drive.py --towns 6 --unseen 3 --held-out london_soho.osm.gz

Needs torch beside ``cityx[sim]``. Every update prints the share of routes that were driven to their
end; at the end the policy drives without noise in each town, in towns that it never saw, and in
each place that was held out.

References
----------
Schulman et al., "Proximal policy optimization algorithms", 2017.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

import cityx.sim
from cityx.sim.places import towns

NAME = "CityX/Drive-v0"
STEPS, EPOCHS, MINIBATCH = 64, 4, 4096
GAMMA, LAMBDA, CLIP, ENTROPY, RATE = 0.99, 0.95, 0.2, 0.0, 5e-4
WIDTH = 128  # of both hidden layers


class Policy(nn.Module):
    """Mean and spread of an action, and the value of a view."""

    def __init__(self, views: int, actions: int) -> None:
        super().__init__()
        self.actor, self.critic = (
            nn.Sequential(
                nn.Linear(views, WIDTH), nn.Tanh(), nn.Linear(WIDTH, WIDTH), nn.Tanh(),
                nn.Linear(WIDTH, out),
            )
            for out in (actions, 1)
        )  # fmt: skip
        self.spread = nn.Parameter(torch.full((actions,), -0.7))

    def chances(self, view: Tensor) -> torch.distributions.Normal:
        """Return the distribution of actions."""
        return torch.distributions.Normal(self.actor(view), self.spread.exp())


class Places:
    """Batches of several places, stepped one after the other as one batch."""

    def __init__(self, batches: Sequence[object]) -> None:
        self.batches = batches
        self.cuts = np.cumsum([batch.num_envs for batch in batches])[:-1]

    def reset(self, seed: int) -> NDArray[np.float32]:
        """Begin an episode everywhere."""
        return np.concatenate([
            batch.reset(seed=seed + 1_000_003 * row)[0] for row, batch in enumerate(self.batches)
        ])  # fmt: skip

    def step(self, actions: NDArray[np.float32]) -> tuple[NDArray[np.generic], ...]:
        """Return views, rewards, which episodes are over, which of them by time, and by success."""
        told = [
            batch.step(np.clip(own, -1, 1))
            for batch, own in zip(self.batches, np.split(actions, self.cuts), strict=True)
        ]
        view, reward, ended, late = (np.concatenate([t[i] for t in told]) for i in range(4))
        success = np.concatenate([t[4]["is_success"] for t in told])
        return view, reward, ended | late, late & ~ended, success


def advantages(reward: Tensor, value: Tensor, over: Tensor, last: Tensor) -> tuple[Tensor, Tensor]:
    """Return (t, n) advantages and returns by generalised advantage estimation."""
    found, running = torch.zeros_like(reward), torch.zeros_like(last)
    following = last
    for row in range(len(reward) - 1, -1, -1):
        going = 1.0 - over[row]
        gain = reward[row] + GAMMA * following * going - value[row]
        running = gain + GAMMA * LAMBDA * going * running
        found[row], following = running, value[row]
    return found, found + value


def learn(places: Places, views: int, seconds: float, device: str, seed: int) -> Policy:
    """Learn for some seconds of processor time, of all threads."""
    torch.manual_seed(seed)
    policy = Policy(views, 2).to(device)
    steps = torch.optim.Adam(policy.parameters(), lr=RATE)
    view, begun, total, update, spent = places.reset(seed), time.process_time(), 0, 0, 0.0
    while spent < seconds:
        kept: dict[str, list[Tensor]] = {name: [] for name in ("view", "action", "chance", "value")}
        rewards, overs, done, won = [], [], 0, 0
        for _ in range(STEPS):
            seen = torch.as_tensor(view, device=device)
            with torch.no_grad():
                chances = policy.chances(seen)
                action = chances.sample()
                row = (seen, action, chances.log_prob(action).sum(1), policy.critic(seen)[:, 0])
            for name, value in zip(kept, row, strict=True):
                kept[name].append(value)
            view, reward, over, _, success = places.step(action.cpu().numpy())
            rewards.append(reward)
            overs.append(over)
            done, won = done + int(over.sum()), won + int(success.sum())
        total += len(view) * STEPS
        data = {name: torch.stack(rows) for name, rows in kept.items()}
        reward = torch.as_tensor(np.stack(rewards), dtype=torch.float32, device=device)
        over = torch.as_tensor(np.stack(overs), dtype=torch.float32, device=device)
        with torch.no_grad():
            last = policy.critic(torch.as_tensor(view, device=device))[:, 0]
        gain, goal = advantages(reward, data["value"], over, last)
        flat = {name: value.flatten(0, 1) for name, value in data.items()}
        gain, goal = gain.flatten(), goal.flatten()
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(gain), device=device).split(MINIBATCH):
                chances = policy.chances(flat["view"][rows])
                ratio = (chances.log_prob(flat["action"][rows]).sum(1) - flat["chance"][rows]).exp()
                own = (gain[rows] - gain[rows].mean()) / (gain[rows].std() + 1e-8)
                loss = -torch.min(ratio * own, ratio.clamp(1 - CLIP, 1 + CLIP) * own).mean()
                value = policy.critic(flat["view"][rows])[:, 0]
                loss = loss + 0.5 * nn.functional.smooth_l1_loss(value, goal[rows])
                loss = loss - ENTROPY * chances.entropy().sum(1).mean()
                steps.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(policy.parameters(), 0.5)
                steps.step()
        update += 1
        spent = time.process_time() - begun
        for group in steps.param_groups:  # to nothing at the end
            group["lr"] = RATE * max(1.0 - spent / seconds, 0.02)
        if update % 10 == 0:
            print(json.dumps({
                "update": update, "steps": total, "cpu_s": round(spent, 1), "routes": done,
                "success": round(won / max(done, 1), 3), "reward": round(float(reward.mean()), 3),
            }), flush=True)  # fmt: skip
    return policy


def judge(policy: Policy, batch: object, device: str, episodes: int, seed: int) -> dict[str, float]:
    """Drive without noise; return shares of routes and what went wrong on a kilometre."""
    view, done, won, cost, metres = batch.reset(seed=seed)[0], 0, 0, 0.0, 0.0
    while done < episodes:
        with torch.no_grad():
            action = policy.actor(torch.as_tensor(view, device=device)).cpu().numpy()
        view, _, ended, late, info = batch.step(np.clip(action, -1, 1))
        over = ended | late
        done, won = done + int(over.sum()), won + int(info["is_success"].sum())
        cost += float(info["cost"].sum())
        metres += float(info["route_completion"][over].sum()) * 120.0
    return {"routes": done, "success": round(won / done, 3),
            "costs_per_km": round(cost / max(metres / 1000, 1e-9), 2)}  # fmt: skip


def main() -> None:
    """Learn and judge, as the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--towns", type=int, default=6, help="made towns to learn in")
    parser.add_argument("--unseen", type=int, default=1, help="made towns never learnt in")
    parser.add_argument("--places", nargs="*", default=[], help="folders to learn in besides")
    parser.add_argument("--held-out", nargs="*", default=[], help="maps or folders never learnt in")
    parser.add_argument("--worlds", type=int, default=64, help="of each place")
    parser.add_argument("--traffic", type=int, default=10, help="vehicles in each world")
    parser.add_argument("--seconds", type=float, default=240.0,
                        help="of processor time that it learns for")  # fmt: skip
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="file of the policy")
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    own = {"control": "target", "traffic": args.traffic, "threads": args.threads}
    made = [*(towns(args.towns) if args.towns else ()), *args.places]
    batches = [cityx.sim.make_vec(NAME, place, num_envs=args.worlds, **own) for place in made]
    views = batches[0].single_observation_space.shape[0]
    policy = learn(Places(batches), views, args.seconds, args.device, args.seed)
    if args.out is not None:
        torch.save(policy.state_dict(), args.out)
    unseen = towns(args.unseen, split="test") if args.unseen else ()
    held = [(name, cityx.sim.make_vec(NAME, place, num_envs=args.worlds, **own))
            for name, place in (
                *((f"unseen town {number}", place) for number, place in enumerate(unseen)),
                *((place, place) for place in args.held_out),
            )]  # fmt: skip
    names = [f"town {number}" for number in range(args.towns)] + args.places
    for name, batch in (*zip(names, batches, strict=True), *held):
        print(
            json.dumps({"place": name, **judge(policy, batch, args.device, 300, 10**6)}), flush=True
        )


if __name__ == "__main__":
    main()
