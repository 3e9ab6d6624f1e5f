function cells = items(list)
% Elements of a list, which may have been decoded as a struct array or as a cell array.
  if isempty(list)
    cells = {};
  elseif iscell(list)
    cells = list(:)';
  else
    cells = num2cell(list(:)');
  end
end
