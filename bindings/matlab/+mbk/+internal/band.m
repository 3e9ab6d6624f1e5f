function band(x, low, high, light)
% What lies between two lines, where both are there. Later lines are drawn over it.
  x = x(:)';
  low = low(:)';
  high = high(:)';
  there = isfinite(low) & isfinite(high);
  if any(there)
    fill([x(there), fliplr(x(there))], [low(there), fliplr(high(there))], light, 'EdgeColor', 'none');
    hold on
  end
end
