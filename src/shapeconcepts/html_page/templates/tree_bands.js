// Where the groups of the tree of concepts lie: children beside each other in the band of their parent, the granularity across.
// `roomFor`: number of smallest groups -> height of all, and the least height of one, so that it can be read.
function treeBands(groups, roomFor) {
  const isLeaf = groups.map(() => true);
  groups.forEach((group) => { if (group.parent >= 0) isLeaf[group.parent] = false; });
  const nLeaves = isLeaf.filter(Boolean).length, nScans = groups.reduce((sum, group, i) => sum + (isLeaf[i] ? group.size : 0), 0);
  const [room, least] = roomFor(nLeaves);
  const heights = groups.map(() => 0), tops = groups.map(() => 0);
  groups.forEach((group, i) => {
    // As high as the group is large, but for the least height.
    if (isLeaf[i]) heights[i] = least + (room - least * nLeaves) * group.size / nScans;
    if (group.parent >= 0) heights[group.parent] += heights[i];
  });
  const free = new Map([[-1, 0]]);
  for (let i = groups.length - 1; i >= 0; i--) {
    const parent = groups[i].parent;
    tops[i] = free.get(parent);
    free.set(parent, tops[i] + heights[i]);
    free.set(i, tops[i]);
  }
  const shares = groups.flatMap((group) => [group.from, group.to]).filter((share) => share > 0 && share < 1);
  const first = Math.max(Math.min(0.02, ...shares) / 2, 1e-4);
  // Of what two groups have in common, 0 to 1, the logarithm.
  const along = (share) => Math.max(Math.log(Math.max(share, first) / first) / Math.log(1 / first), 0);
  return { isLeaf, nLeaves, room, heights, tops, first, along };
}
